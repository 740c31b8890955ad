"""What the desk's pages show: rows, filters, forms, maps."""
