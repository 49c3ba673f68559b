"""The page of a diagnosis: verdict, tables and figures."""
