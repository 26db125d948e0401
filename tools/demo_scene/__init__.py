"""The demo scene of Kairos: a square at dusk, made of code."""
