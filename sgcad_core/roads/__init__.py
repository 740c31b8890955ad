"""Roads before any file format: layouts, their geometry, connections and words."""
