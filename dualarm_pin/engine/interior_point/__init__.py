"""The whole path: a primal-dual interior point that uses the structure of neighbours."""
