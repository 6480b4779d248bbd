"""The chapter's maze."""
