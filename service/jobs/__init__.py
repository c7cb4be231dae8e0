"""Jobs that outlive the process: `port` (what the routes see), `dbos_jobs` (what stands behind it), `store` (rows),
`blobs` (files by content), `executor` (DBOS, which hands jobs to the pool), `leases` (who is alive), `batches` (lines).
"""
