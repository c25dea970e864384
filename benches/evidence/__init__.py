"""The tables of docs/src/evidence: what measures each, and how what a command prints becomes a table."""

from . import diagnosis, estimation, growth, live, recordings, shaping

TABLES = [table for module in (shaping, estimation, live, growth, diagnosis, recordings) for table in module.TABLES]
