"""The run-time part of the embedded model: how it sees a drawing. Weights lie in `weights/`; how they were made, in
research/."""
