"""Interfaces of instruments: ``ticked`` for those that count their own ticks, ``polled`` for those that are queried."""
