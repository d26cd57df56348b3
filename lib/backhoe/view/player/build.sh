#!/bin/sh
# Rebuilds player.js from src/ with the pinned three.js and esbuild; needs Node 20 and npm.
#   sh build.sh           writes player.js
#   sh build.sh --check   fails when player.js is not what src/ builds
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -R "$here/src" "$here/package.json" "$here/package-lock.json" "$work"
cd "$work"
sources=$(LC_ALL=C sh -c "cat src/* package.json package-lock.json" | sha256sum | cut -c1-16)
npm ci --silent --no-audit --no-fund
version=$(node -p 'require("./package.json").devDependencies.three')
notice="three.js $version, (c) three.js authors, SPDX-License-Identifier: MIT, see LICENSE-three.txt"
node_modules/.bin/esbuild src/main.js --bundle --minify --target=es2022 --charset=utf8 \
    --format=iife --global-name=backhoePlayer --loader:.css=text --legal-comments=none \
    --banner:js="/* Backhoe replay player, built by build.sh. Sources $sources. Contains $notice. */" \
    --log-level=warning --outfile=player.js
if [ "${1:-}" = "--check" ]; then
    cmp player.js "$here/player.js"
else
    cp player.js "$here/player.js"
fi
