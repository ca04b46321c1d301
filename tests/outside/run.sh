#!/usr/bin/env bash
# Judges 3 worlds of each kind (or as many as `--count` says) with programs of others, after the judges
# have shown that they notice what is wrong, and then the bags of trials. Arguments are those of judge.py. Needs what
# `cargo build --release -p envgen --features cli,usd` and `cargo build --release --example mapping_trial` build,
# Python 3.10 to 3.12, libcairo2 and Node with npm; what requirements.txt names goes to target/outside, about 1.7 GB.
set -euo pipefail
cd "$(dirname "$0")/../.."

here=tests/outside
venv=target/outside/venv
pins=$venv/requirements.txt
if ! cmp -s $here/requirements.txt $pins; then
  rm -rf $venv
  "${PYTHON:-python3}" -m venv $venv
  # Installs in parallel: pip alone takes minutes.
  $venv/bin/pip install --quiet --disable-pip-version-check uv==0.13.9
  $venv/bin/uv pip install --quiet --python $venv/bin/python --no-deps --only-binary :all: \
    --requirements $here/requirements.txt
  cp $here/requirements.txt $pins
fi
validator=gltf-validator@2.0.0-dev.3.10
node=target/outside/node
if ! grep -qsx $validator $node/installed; then
  rm -rf $node
  mkdir -p $node
  npm install --silent --no-fund --no-audit --no-package-lock --prefix $node $validator
  echo $validator > $node/installed
fi
# Python's compiled files go beside the installed packages and not into the sources.
export PYTHONPYCACHEPREFIX=$PWD/target/outside/pycache PYTHONDONTWRITEBYTECODE=
rm -rf target/outside/complaints
$venv/bin/python $here/self_test.py "$@"
$venv/bin/python $here/judge.py --keep target/outside/complaints "$@"
$venv/bin/python $here/bags.py
# What the guide's command with `--camera` wrote, which needs a driver for drawing.
if [ -e out/frames/frames.json ]; then $venv/bin/python $here/frames.py; else echo "left out: pictures of cameras"; fi
