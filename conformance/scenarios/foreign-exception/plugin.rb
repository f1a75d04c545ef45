require "rtf"

class ForeignException < RTF::TestCase
  def run
    throw 42
  end
end
