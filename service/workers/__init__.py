"""Work in processes that can be killed: `pool` (the web process's side), `nursery` (forks them), `wire` (between), `solve`."""
