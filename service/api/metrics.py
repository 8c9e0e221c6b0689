"""Metrics of a server, for Prometheus."""

from __future__ import annotations

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest

_SECONDS = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 60.0)


class Metrics:
    """The counters of one server, in a registry of its own."""

    def __init__(self) -> None:
        self.registry = CollectorRegistry()
        self.requests = Counter(
            "samplerscope_requests", "Requests answered.", ("route", "method", "status"), registry=self.registry
        )
        self.duration = Histogram(
            "samplerscope_request_duration_seconds",
            "Time until a request was answered.",
            ("route",),
            buckets=_SECONDS,
            registry=self.registry,
        )
        self.answers = Counter(
            "samplerscope_answers",
            "Answers by how they came about: hit (stored), shared (with an equal request), computed.",
            ("how", "kind"),
            registry=self.registry,
        )
        self.device_ms = Counter(
            "samplerscope_device_milliseconds", "Time on the device for direct answers.", registry=self.registry
        )
        self.jobs = Counter("samplerscope_jobs", "Jobs that reached a state.", ("state",), registry=self.registry)
        self.restarts = Counter(
            "samplerscope_worker_restarts", "Workers that were lost and replaced.", ("lane",), registry=self.registry
        )
        self.queue = Gauge("samplerscope_queue_length", "Tasks that wait.", ("lane",), registry=self.registry)
        self.running = Gauge("samplerscope_running", "Tasks that a worker is at.", ("lane",), registry=self.registry)
        for lane in ("direct", "jobs", "encode", "own"):
            self.restarts.labels(lane)

    def text(self) -> bytes:
        """The exposition format."""
        return generate_latest(self.registry)
