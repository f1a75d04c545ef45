-- Lua has no abort(): the process gets the signal from a child, whose parent it is.
function TestCase.run()
  rtf.report("before the abort")
  os.execute("kill -ABRT $PPID")
end
