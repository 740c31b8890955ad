"""Several hosts on one machine: `make test-hosts`; not part of `make test`."""
