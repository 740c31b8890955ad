"""The embedded model's run-time code: from a drawing to patches. The weights are in `weights/`, the training in
research/."""
