"""Contents of the desk's pages: rows, filters, forms, maps."""
