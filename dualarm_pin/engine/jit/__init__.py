"""How the engine is compiled: decorators, records by address, functions by address."""
