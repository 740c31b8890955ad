"""GGUF files run by llama.cpp in this process, weights kept as they are packed: rows, words and files."""
