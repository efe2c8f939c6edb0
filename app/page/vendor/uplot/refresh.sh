#!/bin/sh
# Fetches uPlot VERSION from npm and replaces the three files beside this script: ./refresh.sh VERSION
set -eu
version=${1:?usage: refresh.sh VERSION}
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
tar xf "$(npm pack --silent "uplot@$version")"
cp package/dist/uPlot.iife.min.js package/dist/uPlot.min.css package/LICENSE "$here"
