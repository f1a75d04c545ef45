-- Lua cannot reach memory that is not there: the process gets the signal from
-- a child, whose parent it is.
function TestCase.run()
  rtf.report("before the crash")
  os.execute("kill -SEGV $PPID")
end
