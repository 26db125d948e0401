namespace kairos {}
