"""Jobs that outlive the process.

::

    routes ──> port ──> dbos_jobs ──> keeper ──> store, tables, engine   rows
                            │            ├─────> executor ──> work       DBOS gives out chunks; the pool works on them
                            │            └─────> leases                  who is alive
                            └──> batches ──────> blobs                   lines in, files by content
"""
