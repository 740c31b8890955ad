"""The embedded vision-language model: its report generator, renderer, trainer and weights."""
