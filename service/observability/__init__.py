"""What the service tells its operators: metrics, logs and traces.

`metrics` has every figure that Prometheus may ask for, `logs` makes each line of standard error a JSON document, `telemetry`
hands spans to OpenTelemetry where a collector is configured, and `requests` is what the middleware calls for each request.
"""
