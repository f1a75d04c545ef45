#!/bin/sh
# Prints measurements for CTest: `measures.sh [EXIT CODE]`.
echo note >note.txt
echo core >core.txt
cat <<'END'
<CTestMeasurement type="numeric/double" name="speed">1.5</CTestMeasurement>
<CTestMeasurement type="text/string" name="gripper">two &lt;fingers&gt;</CTestMeasurement>
<CTestMeasurementFile type="text/plain" name="a note">note.txt</CTestMeasurementFile>
<CTestDetails>no details</CTestDetails>
END
exit "${1:-0}"
