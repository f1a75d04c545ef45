function TestCase.run()
  rtf.fixture_value("simulator.speed")
  rtf.report("never")
end

function TestCase.tearDown()
  rtf.report("torn down")
end
