"""Experiments: configuration in, metrics, figures and a recording out."""
