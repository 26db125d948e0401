"""Benchmark scenes of Kairos, made of code: one module per scene, each with make(folder, options)."""
