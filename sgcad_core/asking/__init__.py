"""How a writer asks a model, and is asked again: prompts, schemas, findings."""
