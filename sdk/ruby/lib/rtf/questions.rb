# frozen_string_literal: true

require "rtf/attachment"
require "rtf/location"
require "rtf/stop"
require "rtf/text"

module RTF
  # Questions to an operator.
  class Questions
    ANSWER_SECONDS = 300
    SIGNATURES = { "\x89PNG\r\n\x1A\n".b => "image/png", "\xFF\xD8\xFF".b => "image/jpeg" }.freeze
    private_constant :SIGNATURES

    @lock = Mutex.new
    @last = 0

    # A number that is unique in the process, which may serve several tests.
    def self.next_number
      @lock.synchronize { @last += 1 }
    end

    def initialize(session)
      @session = session
    end

    # Asks, and waits for the answer; without one, it reports an error and ends the step.
    def ask(text, choices, timeout:, default:, picture:)
      number = Questions.next_number
      fields = { question: number, text: Text.utf8(text), default: default && Text.utf8(default),
                 choices: choices.map { |choice| Text.utf8(choice) },
                 timeout_ms: [(Float(timeout) * 1000).round, 0].max,
                 picture: picture && attach(File.expand_path(picture)),
                 location: Location.caller_place }
      @session.request.open_question(number)
      @session.notify_in_case("question-asked", fields.compact)
      answer(number)
    end

    private

    def answer(number)
      request = @session.request
      ended = request.wait_for_answer(number)
      raise Interrupted, request.stop_reason if ended.nil?

      ended[:answer] || @session.end_with_error(ended[:problem])
    end

    # Attaches a picture, and returns the path of the copy.
    def attach(path)
      Attachment.check(path)
      start = File.binread(path, 8) || ""
      type = SIGNATURES.find { |signature, _| start.start_with?(signature) }&.last
      @session.end_with_error("the picture `#{path}` is neither PNG nor JPEG") unless type
      @session.attach(path, File.basename(path), type)
    end
  end
end
