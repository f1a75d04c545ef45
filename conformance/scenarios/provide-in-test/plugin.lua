function TestCase.run()
  rtf.provide("port", 40123)
end
