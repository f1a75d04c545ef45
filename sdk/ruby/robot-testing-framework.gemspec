# frozen_string_literal: true

require_relative "lib/rtf/version"

Gem::Specification.new do |spec|
  spec.name = "robot-testing-framework"
  spec.version = RTF::VERSION
  spec.summary = "Write tests and fixtures for the Robot Testing Framework in Ruby"
  spec.authors = ["The Robot Testing Framework's authors"]
  spec.license = "Apache-2.0"
  spec.required_ruby_version = ">= 3.0"
  spec.files = Dir["lib/**/*.rb"] + ["README.md"]
  spec.metadata["rubygems_mfa_required"] = "true"
end
