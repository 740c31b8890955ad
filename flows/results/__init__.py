"""Tables, figures and one HTML page of finished runs, from study.json and the case folders."""
