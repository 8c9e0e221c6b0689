"""Report cards of checks and of stability: one file fit for a pull request, as HTML, JSON or Markdown."""

from service.reports.card import require_report, write_report

__all__ = ["require_report", "write_report"]
