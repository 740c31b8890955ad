"""What a case is on disk: its report, its folder, its fingerprints, results shared between configs, links to pages."""
