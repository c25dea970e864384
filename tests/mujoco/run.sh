#!/bin/sh
# Generates concealed cases with MuJoCo: run.sh OUT [--cases 60] [--seed 1]; or run.sh --check.
# Exits 77 (skipped) where MuJoCo cannot be installed.
here=${0%/*}
script=generate.py
[ "$1" = "--check" ] && script=check.py && shift
exec "$here/../absent/python.sh" "$here/requirements.txt" "$here/$script" "$@"
