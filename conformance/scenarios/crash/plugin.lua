-- Lua cannot read unmapped memory: a child sends the signal to its parent, this
-- process.
function TestCase.run()
  rtf.report("before the crash")
  os.execute("kill -SEGV $PPID")
end
