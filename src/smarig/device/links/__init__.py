"""Links move requests and replies between host and device: one file per kind. They know bytes and no meaning."""
