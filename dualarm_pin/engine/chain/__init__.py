"""One point: where the chain stands, and value, gradient and Hessian of index and rows there."""
