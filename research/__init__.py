"""What is not shipped: generator of made reports, renderer, model training, benchmarks."""
