"""What may be said about an optimum: a local check, starts by two laws, a lower bound."""
