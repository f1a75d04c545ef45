function TestCase.run()
  rtf.report("before the crash")
  os.execute("kill -SEGV $PPID")
end
