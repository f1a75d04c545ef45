function TestCase.run()
  rtf.fault("drop")
  rtf.report("not reached")
end
