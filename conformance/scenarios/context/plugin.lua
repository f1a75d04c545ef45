function TestCase.run()
  rtf.report(table.concat({ rtf.name(), rtf.param(), rtf.environment(), rtf.repetition() }, " "))
end
