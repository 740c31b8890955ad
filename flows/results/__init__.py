"""Finished runs made readable: tables, figures and one HTML page, from study.json and the case folders alone."""
