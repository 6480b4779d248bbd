"""Whose body is this?"""
