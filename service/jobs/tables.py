"""The tables of jobs, beside DBOS's own in the same database. Rows hold digests, never payloads.

Times are seconds since 1970 by the clock of the database, where it has one: machines need not agree about the time.
"""

from __future__ import annotations

import sqlalchemy as sa

METADATA = sa.MetaData()

JOBS = sa.Table(
    "mat_jobs",
    METADATA,
    sa.Column("id", sa.String(32), primary_key=True),
    sa.Column("owner", sa.String, nullable=False),  # "" where no keys are in force
    sa.Column("key", sa.String),  # the Idempotency-Key
    sa.Column("fingerprint", sa.String(64), nullable=False),  # of everything a repeated request must repeat
    sa.Column("operation", sa.String, nullable=False),
    sa.Column("format", sa.String, nullable=False),
    sa.Column("options", sa.JSON, nullable=False),
    sa.Column("state", sa.String, nullable=False),
    sa.Column("created", sa.Float, nullable=False),
    sa.Column("started", sa.Float),
    sa.Column("updated", sa.Float, nullable=False),
    sa.Column("finished", sa.Float),
    sa.Column("progress", sa.Integer, nullable=False),
    sa.Column("message", sa.String, nullable=False),
    sa.Column("batch", sa.Boolean, nullable=False),
    sa.Column("failure", sa.String(64)),  # digest of why it failed
    sa.UniqueConstraint("owner", "key"),
    sa.Index("mat_jobs_newest", "created", "id"),
    sa.Index("mat_jobs_state", "state", "finished"),
    sa.Index("mat_jobs_failure", "failure"),
)

CHUNKS = sa.Table(
    "mat_chunks",
    METADATA,
    sa.Column("job", sa.String(32), sa.ForeignKey("mat_jobs.id", ondelete="CASCADE"), primary_key=True),
    sa.Column("number", sa.Integer, primary_key=True),  # 0 for a job of one request
    sa.Column("first", sa.Integer, nullable=False),  # lines of the batch before it
    sa.Column("domains", sa.Integer, nullable=False),
    sa.Column("body", sa.String(64), nullable=False),
    sa.Column("result", sa.String(64)),  # set once it is finished
    sa.Column("failed", sa.Integer),  # domains whose line is a problem
    sa.Index("mat_chunks_body", "body"),
    sa.Index("mat_chunks_result", "result"),
)

LEASES = sa.Table(
    "mat_leases",
    METADATA,
    sa.Column("executor", sa.String, primary_key=True),
    sa.Column("expires", sa.Float, nullable=False),
)
