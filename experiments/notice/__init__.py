"""A body changes while it imitates: does it notice, and does it learn?"""
