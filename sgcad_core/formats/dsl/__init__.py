"""OpenSCENARIO DSL 2.1: a crash as text for people, and for tools that read the language."""
