"""What a Preisach operator needs of a wire: surfaces, tables, relays, one file each."""
