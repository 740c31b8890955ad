"""SUMO's files: plain XML, .net.xml and route files."""
