-- The parameter names a variable that says what the test does.
TestCase = {}

-- The number of times that this was called, in a file.
local function count()
  local file = io.open(os.getenv("ARM_DIR") .. "/count.txt", "a+")
  file:write("x")
  file:seek("set")
  return #file:read("a")
end

function TestCase.run()
  local name = rtf.param()
  local behaviour = os.getenv(name) or (name == "ARM_KNOWN" and "fail")
  rtf.report("the arm moves")
  if behaviour == "fail" then
    rtf.fail("the arm is bent")
  elseif behaviour == "fail second time" then
    rtf.check(count() ~= 2, "the second time")
  elseif behaviour == "crash" then
    os.exit(3)
  elseif behaviour == "skip" then
    rtf.skip("no gripper")
  elseif behaviour == "hang" then
    while true do end
  elseif behaviour == "kill" then
    -- The guard of rtf and the runner, which is the parent of this process or of its parent.
    os.execute([[
      pid=$PPID programs=
      while [ "$pid" -gt 1 ]; do
        read -r line <"/proc/$pid/stat"
        case $line in *"(rtf)"*) programs="$pid $programs" ;; esac
        rest=${line##*) }
        rest=${rest#* }
        pid=${rest%% *}
      done
      kill -9 $programs
      sleep 5]])
  end
end
