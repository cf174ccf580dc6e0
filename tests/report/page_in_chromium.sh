#!/bin/sh
# The tests of pages in a browser: page_in_chromium.sh TOOL SOURCE_DIR. Exits with 77 where Node, npm
# or Chromium (Debian: nodejs npm chromium) is missing, or where one of the tests was skipped.
set -u
for program in node npm "${CHROMIUM:-chromium}"; do
  command -v "$program" >/dev/null 2>&1 || { echo "skipped: no $program"; exit 77; }
done
out=$(STILLBASE_TOOL=$1 STILLBASE_SOURCE_DIR=$2 \
  timeout --kill-after=10 500 \
  node --test --test-reporter=spec "$(dirname "$0")/page_in_chromium.mjs" 2>&1)
code=$?
echo "$out"
[ $code -ne 0 ] && exit $code
echo "$out" | grep -q 'skipped [1-9]' && { echo "skipped: some tests, see above"; exit 77; }
exit 0
