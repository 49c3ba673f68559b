"""Plug-ins for smarig, one file each. smarig imports this package only when a command names one of them."""
