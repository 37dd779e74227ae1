#!/bin/bash
# Corrects models for the mesh of their data, and makes their error bars by simulations without its error.
#
#   models/datasets/error_bars.sh [FAMILY ...]        by default all families of which there are such simulations
#
# Environment: SUPPLE_LAB, the batch tool (build/release/engine/lab/supple-lab).
set -euo pipefail
cd "$(dirname "$0")/../.."
case "${1:-}" in
  -h | --help) sed -n '2,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac
lab=${SUPPLE_LAB:-build/release/engine/lab/supple-lab}
sets=models/datasets

# The sets of the training in its order: other sets would be split into other designs that training has not seen.
data_of() {
  case $1 in
    IH01) echo "--data $sets/IH01.h5 --more $sets/IH01-more.h5" ;;
    IH22) echo "--data $sets/IH22.h5 --more $sets/IH22-dense.h5" ;;
    IH28) echo "--data $sets/IH28.h5 --more $sets/IH28-dense.h5 --more $sets/IH28-more.h5" ;;
    IH29) echo "--data $sets/IH29.h5 --more $sets/IH29-low.h5" ;;
    *) echo "--data $sets/$1.h5" ;;
  esac
}

make_bars() { # FAMILY MODEL
  local family=$1 model=$2 data set references=()
  read -ra data <<<"$(data_of "$family")"
  for set in "$sets/$family"-fresh-*.h5; do references+=(--reference "$set"); done
  [ ! -e "$sets/$family-searched.h5" ] || references+=(--searched "$sets/$family-searched.h5")
  "$lab" correct-mesh --model "$model" "${data[@]}" --rest-data "$sets/$family-rest-mesh.h5" \
      --reference "$sets/$family-rest-exact.h5" --out "$model"
  "$lab" calibrate --model "$model" "${data[@]}" "${references[@]}"
  "$lab" card --model "$model" "${data[@]}" --image "$(basename "${model%.h5}")-errors.svg" --out "${model%.h5}.md"
  # The card of a model in a folder of its own links to the documents from there, and has no picture of its errors.
  [[ $model != models/fine/* ]] || sed -i -e 's#](\.\./docs/#](../../docs/#g' -e '/-errors\.svg)/,+1d' "${model%.h5}.md"
}

if [ $# = 0 ]; then
  for family in IH01 IH21 IH22 IH28 IH29 IH50 IH67; do
    [ ! -e "$sets/$family-rest-exact.h5" ] || set -- "$@" "$family"
  done
fi
for family; do
  make_bars "$family" "models/${family,,}.h5"
  [ ! -e "models/fine/${family,,}.h5" ] || make_bars "$family" "models/fine/${family,,}.h5"
done
