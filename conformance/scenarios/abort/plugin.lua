function TestCase.run()
  rtf.report("before the abort")
  os.execute("kill -ABRT $PPID")
end
