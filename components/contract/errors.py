"""The root of all errors that are meant for people."""


class FanfoldError(Exception):
    """A sentence, or several in lines: what is wrong, where, and what to do."""
